"""Character drawing of the rotor, side view to scale: stepped shaft with bore, disks, bearings below, probes above.

A character is taken to be twice as high as wide, so half of one, as in ▀ and ▄, is a square of the drawing.
"""

from rich.text import Text

from rotorrig.rig.config import RigConfig

STYLES = {"disk": "cyan", "bearing": "green", "probe": "yellow", "ruler": "dim", "shaft": ""}
PLAIN = str.maketrans({"█": "#", "▀": '"', "▄": "_", "▲": "^", "▼": "v", "│": "|", "─": "-", "┬": "+", "▓": "#"})
FEWEST = 24  # columns, the minimum width
GAP = 2  # columns between two labels of a line
TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)  # mm
PER_TICK = 9  # columns, at the least

Label = tuple[int, str, str]  # column, words, kind of part


def draw_rotor(rig: RigConfig, *, width: int, plain: bool = False) -> Text:
    """Return the drawing, at most `width` columns wide; `plain` uses ASCII alone."""
    width = max(width, FEWEST)
    square = rig.shaft.length / (width - 1)  # m of a column, and of half a row
    above = [(_column(p, square), ", ".join(names), "probe") for p, names in _probe_planes(rig)]
    above += [(_column(d.position, square), d.name, "disk") for d in rig.disks]
    below = [(_column(b.position, square), b.name, "bearing") for b in rig.bearings]
    thickness = _thickness(rig, width, square)
    half = max(outer for outer, _, _ in thickness)
    upper, lower = _lanes(above, width), _lanes(below, width)
    middle = len(upper) + (half + 1) // 2 + 1  # the row of the axis; one row is left for ▼ on the largest disk
    sheet = _Sheet(middle + half // 2 + 2 + len(lower) + 2, width)
    _draw_body(sheet, thickness, middle)
    for lanes, direction in ((upper, -1), (lower, 1)):
        _draw_parts(sheet, lanes, thickness, middle=middle, direction=direction)
    _draw_ruler(sheet, rig.shaft.length * 1e3)
    return sheet.text(plain=plain)


class _Sheet:
    """Rows of characters, each with a style."""

    def __init__(self, rows: int, width: int) -> None:
        self.rows = rows
        self.width = width
        self._characters = [[" "] * width for _ in range(rows)]
        self._styles = [[""] * width for _ in range(rows)]

    def put(self, row: int, column: int, words: str, kind: str) -> None:
        for i, character in enumerate(words, column):
            self._characters[row][i] = character
            self._styles[row][i] = STYLES[kind]

    def is_free(self, row: int, column: int) -> bool:
        return self._characters[row][column] == " "

    def text(self, *, plain: bool) -> Text:
        whole = Text(no_wrap=True, overflow="crop")
        for characters, styles in zip(self._characters, self._styles, strict=True):
            for character, style in zip(characters, styles, strict=True):
                whole.append(character.translate(PLAIN) if plain else character, style)
            whole.append("\n")
        whole.right_crop(1)
        return whole


def _column(position: float, square: float) -> int:
    return round(position / square)


def _probe_planes(rig: RigConfig) -> list[tuple[float, list[str]]]:
    places = sorted({p.position for p in rig.probes})
    return [(place, [p.name for p in rig.probes if p.position == place]) for place in places]


def _thickness(rig: RigConfig, width: int, square: float) -> list[tuple[int, int, str]]:
    """Return for each column the squares from the axis to the surface, those that are bored, and what it is."""
    columns = []
    for column in range(width):
        z = column * square
        tube = next((t for t in rig.shaft.tubes if z <= t.end + square / 2), rig.shaft.tubes[-1])
        outer = _squares(tube.diameter, square)
        columns.append((outer, min(outer, int(tube.inner_diameter / 2 / square + 0.5)), "shaft"))
    for disk in rig.disks:
        first = _column(max(disk.position - disk.width / 2, 0.0), square)
        wide = max(1, round(disk.width / square))
        for column in range(first, min(first + wide, width)):
            columns[column] = (max(columns[column][0], _squares(disk.diameter, square)), 0, "disk")
    return columns


def _squares(diameter: float, square: float) -> int:
    """Return the squares beyond the one on the axis that half a diameter covers."""
    return max(0, round(diameter / 2 / square - 0.5))


def _draw_body(sheet: _Sheet, thickness: list[tuple[int, int, str]], middle: int) -> None:
    """Fill the squares; the one on the axis is the upper half of the middle row."""
    for column, (outer, bore, kind) in enumerate(thickness):
        for row in range(middle - (outer + 1) // 2, middle + outer // 2 + 1):
            up, down = (bore <= abs(2 * (row - middle) + i) <= outer for i in (0, 1))
            sheet.put(row, column, {(1, 1): "█", (1, 0): "▀", (0, 1): "▄", (0, 0): " "}[up, down], kind)


def _lanes(labels: list[Label], width: int) -> list[list[tuple[int, Label]]]:
    """Return the labels in as few lines as keep them apart, nearest the rotor first: (first column, label)."""
    lanes: list[list[tuple[int, Label]]] = []
    for label in sorted(labels):
        column, words, kind = label[0], label[1][:width], label[2]
        start = min(max(column - len(words) // 2, 0), width - len(words))
        for lane in lanes:
            if start >= lane[-1][0] + len(lane[-1][1][1]) + GAP:
                break
        else:
            lanes.append(lane := [])
        lane.append((start, (column, words, kind)))
    return lanes


def _draw_parts(
    sheet: _Sheet,
    lanes: list[list[tuple[int, Label]]],
    thickness: list[tuple[int, int, str]],
    *,
    middle: int,
    direction: int,
) -> None:
    """Write the labels and lead a line from each to its part, above (-1) or below (+1) the axis."""
    half = max(outer for outer, _, _ in thickness)
    near = middle - (half + 1) // 2 - 2 if direction < 0 else middle + half // 2 + 2
    for number, lane in enumerate(lanes):
        for start, (_, words, kind) in lane:
            sheet.put(near + direction * number, start, words, kind)
    for number, lane in enumerate(lanes):
        for _, (column, _, kind) in lane:
            outer = thickness[column][0]
            surface = middle - (outer + 1) // 2 - 1 if direction < 0 else middle + outer // 2 + 1
            for row in range(surface, near + direction * number, direction):
                if sheet.is_free(row, column):
                    sheet.put(row, column, "│", kind)
            if kind != "disk":
                sheet.put(surface, column, "▼" if direction < 0 else "▲", kind)


def _draw_ruler(sheet: _Sheet, length: float) -> None:
    """Draw a scale in mm from the coupling on the last two rows."""
    per_column = length / (sheet.width - 1)
    step = next((t for t in TICKS if t / per_column >= PER_TICK), TICKS[-1])
    sheet.put(sheet.rows - 2, 0, "─" * sheet.width, "ruler")
    for tick in range(int(length // step) + 1):
        column = round(tick * step / per_column)
        words = f"{tick * step}" if tick else "0 mm"
        sheet.put(sheet.rows - 2, column, "┬", "ruler")
        sheet.put(sheet.rows - 1, min(max(column - len(words) // 2, 0), sheet.width - len(words)), words, "ruler")
