"""Studies of many pairs: seeded draws and sweeps over the keys of a pair file, run anywhere, resumed, and answered.

``models`` is the study file, ``design`` says which pair has which number, ``pipeline`` makes one row of the table from
one number, ``run`` makes all rows (``local`` on this machine, ``cluster`` on Dask) and ``store`` keeps them;
``answers`` reads the table, ``page`` shows it. The paper's own questions are in ``gearpoly.studies.paper``.
"""
