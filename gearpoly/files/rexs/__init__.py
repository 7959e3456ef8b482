"""REXS, the open exchange format of gear designs (FVA): read as 1.0 to 1.7 and 2.0, written as 2.0."""
