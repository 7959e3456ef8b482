"""The words of five languages by which a channel's name tells a quantity and a shaft."""

from __future__ import annotations

import re
import unicodedata

from gearpoly.recording.quantities import ANGLE, COUNT, SPEED, TIME, TORQUE

TE, OTHER_QUANTITY = "transmission error", "something else"
RADIAL = "radial composite deviation"
AXIS, WORM = "error of a telescope's axis", "angle of the worm"

QUANTITIES: tuple[tuple[str, str, str], ...] = (
    (
        RADIAL,
        "",
        "zweiflanken|double flank|dual flank|doppelflanken|radial composite|composite radial|double flanc|"
        "doppio fianco|doble flanco|achsabstand|wellenabstand|cent(?:re|er) dist|entraxe|interasse|"
        "distancia entre ejes|radial.*transmission error|transmission error.*radial",
    ),
    (
        TE,
        "te drehwegfehler",
        "tangential composite|single flank|kinematic error|kinematisch|transmission error|transmissionerror|drehfehler|"
        "drehwegabweichung|einflanken|ubertragungsfehler|"
        "uebertragungsfehler|erreur de transmission|error de transmision|errore di trasmissione",
    ),
    (
        AXIS,
        "pe pec raerror rawpe",
        "periodic error|ra error|raw pe|tracking error|schneckenfehler|nachfuhrfehler|"
        "erreur periodique|errore periodico",
    ),
    (WORM, "wormphase wormangle", "worm phase|worm angle|worm position|worm pos|schneckenwinkel|schneckenphase"),
    # A relative time counts from the beginning; what else is relative is of neither shaft.
    (TIME, "", r"relativ\w* ?(?:time|zeit)|(?:time|zeit|tempo|tiempo) relativ"),
    (
        OTHER_QUANTITY,
        "diff dev",
        "temperat|backlash|lost motion|flankenspiel|verdrehspiel|"
        "error|fehler|erreur|abweichung|deviation|torsion|verdreh|beschleun|accel|vibra|kraft|force|differ|delta|"
        "relativ|soll|setpoint|set point|command|target|consigne|consigna|nominal",
    ),
    (
        SPEED,
        "n rpm rev regime nan nab",
        "drehzahl|geschwindigkeit|speed|velocity|vitesse|velocidad|velocita|numero di giri|omega",
    ),
    (TORQUE, "m par md couple coppia", "drehmoment|moment|torque"),
    (
        TIME,
        "t ts time temps tiempo tempo hora ora heure datum date fecha clock epoch stamp millis micros nanos elapsed",
        "zeit|timestamp|time stamp|unix ?time|horodatage",
    ),
    (ANGLE, "phi theta φ θ ϕ ϑ angle angles angulo angolo", "winkel|angle|angulo|angolo"),
    (COUNT, "inc", "counter|counts|zahler|zaehler|inkrement|impulse|compteur|contador|contatore"),
)
"""Quantity, whole words and parts of words, in small letters without accents; the first that fits counts. The row
of something else has quantities that no column holds, some of which have an angle in their names. A word of one letter
counts only with a unit that fits, but for a name that is t."""

SHAFT_WORDS = {
    "driving": (
        "driving driver input entree entrada ingresso entrata menant menante conductor conductora conduttore",
        "antrieb|eingang|input|treibend",
    ),
    "driven": (
        "driven output sortie salida uscita mene menee conducido conducida condotto condotta out",
        "abtrieb|ausgang|output|getrieben",
    ),
}
"""Words and parts of words that name one shaft of a pair and no other."""

ANGULAR_SPEED = re.compile(
    r"winkelgeschw|angular (?:vel|speed|rate)|vitesse angulaire|velocidad angular|velocita angolare|omega"
)
"""Words for a speed of which 1/s is rad/s, and not turns per second."""

BARE_ERRORS = frozenset(["error", "errors", "fehler", "abweichung", "deviation", "erreur", "errore", "ecart"])
"""Words for an error that say nothing of what."""

_NO_SHAFT = re.compile(
    r"analog|digital|kanal|channel|canal|(?:input|output|eingang|ausgang|entree|sortie|entrada|salida|uscita) ?\d"
)
"""Names of a logger's own inputs and outputs, which are no shafts."""

_ALSO_LOGGERS = re.compile(r"\b(?:input|output|eingang|ausgang|entree|sortie|entrada|salida|uscita|ingresso|out)\w*")
"""Words for shafts that loggers have for their own sockets."""

CHANNEL_NAME_LIMIT = 200
"""Characters of a name that are looked at; the longest header of a logger seen has 60."""


_COMPOSITE = re.compile(r"(?<![^\W\d_])[Ff]_?i_?\s?(?P<primes>(?:['\u2032\u2019\u00b4`]|[\"\u2033\u201d\u02ba]){1,2})")
"""F_i', the tangential composite deviation of ISO 1328-1, and F_i'', the radial one of ISO 1328-2."""

CLOCKS = {
    "millis": "ms",
    "milliseconds": "ms",
    "micros": "us",
    "microseconds": "us",
    "nanos": "ns",
    "nanoseconds": "ns",
    "seconds": "s",
    "sekunden": "s",
}
"""Words of programs for the time since they began, with its unit."""

PERCENT = ("pct", "percent", "prozent", "pourcent", "porcentaje", "percento", "perc")
"""Words for per cent in a name."""

INTERVALS = (
    *("dt", "period", "periods", "interval", "intervals", "periode", "perioden", "periodendauer", "intervall"),
    *("intervalle", "periodo", "intervalo", "intervallo"),
)
"""Words for the time between two pulses."""

RUN_WORDS = (
    "run|lauf|laufe|trial|messung|measurement|meas|versuch|essai|mesure|prova|prueba|medicion|misura|wiederholung|"
    "repeat|repetition|rep|durchgang|durchlauf|pass|test"
)
"""Words that are counted where several recordings stand side by side. A series is none: spreadsheets call any column
so."""


def run_of(name: str) -> str:
    """The number of the run that a channel's name says (``run 2 in``), or nothing."""
    found = re.search(rf"\b(?:{RUN_WORDS}) (?:nr |no |number )?(\d{{1,3}})\b", plain(name))
    return found[1] if found else ""


def quantity_of(name: str) -> str:
    """The quantity that the words of a channel's name say, or nothing."""
    composite = _COMPOSITE.search(name[:CHANNEL_NAME_LIMIT])
    if composite is not None:
        primes = composite["primes"]
        return RADIAL if len(primes) > 1 or primes in '"\u2033\u201d\u02ba' else TE
    words, whole_words = plain(name), tokens(name)
    for quantity, whole, parts in QUANTITIES:
        if (set(whole.split()) & whole_words) or re.search(parts, words):
            return quantity
    return ""


def by_letter(name: str) -> bool:
    """Whether one letter alone says the quantity of a channel's name, as in ``n Antrieb``; so do pieces of words in an
    encoding that was not found."""
    words, whole_words = plain(name), tokens(name)
    for _, whole, parts in QUANTITIES:
        held = set(whole.split()) & whole_words
        if held or re.search(parts, words):
            return bool(held) and not re.search(parts, words) and all(len(one) == 1 for one in held)
    return False


def shaft_of(name: str, *, outs: bool = False) -> str:
    """The shaft that a channel's name says, or nothing; ``outs``: another channel of the recording is called out."""
    words, whole_words = plain(name), tokens(name)
    if _NO_SHAFT.search(words):  # a channel of the logger's, which may say its shaft in another word
        words = _ALSO_LOGGERS.sub(" ", words)
        whole_words = set(words.split())
        outs = False
    if outs and "in" in whole_words:
        whole_words.add("input")
    found = [
        shaft
        for shaft, (whole, parts) in SHAFT_WORDS.items()
        if set(whole.split()) & whole_words or re.search(parts, words)
    ]
    return found[0] if len(found) == 1 else ""


def plain(name: str) -> str:
    """A name in small letters, without accents, its words parted by one blank."""
    split = re.sub(r"(?<=[a-zäöü])(?=[A-Z])", " ", name[:CHANNEL_NAME_LIMIT]).translate(_LOWERED)
    bare = unicodedata.normalize("NFD", split.lower())
    # Letters of other alphabets part no words, so that none falls into pieces of one letter.
    return " ".join(re.findall(r"[^\W\d_]+|\d+", "".join(c for c in bare if not unicodedata.combining(c))))


_LOWERED = {0x2080 + k: str(k) for k in range(10)}
"""Lowered digits, as of phi_1."""


def tokens(name: str) -> set[str]:
    return set(plain(name).split())
