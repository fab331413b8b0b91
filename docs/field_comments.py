"""What the comments beside the fields of a class say: on the field's last line, or in whole lines just above it."""

import ast
import inspect
import io
import textwrap
import tokenize


def comments(kind: type) -> dict[str, str]:
    """Return field name -> comment of a class and of those it inherits from; a field without one is left out."""
    found: dict[str, str] = {}
    for owner in reversed(kind.__mro__):
        if "__annotations__" in vars(owner) and not owner.__module__.startswith("pydantic"):
            found |= _own(textwrap.dedent(inspect.getsource(owner)))
    return found


def _own(source: str) -> dict[str, str]:
    (body,) = ast.parse(source).body
    assert isinstance(body, ast.ClassDef)
    beside, above = _by_line(source)
    found = {}
    for field in body.body:
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            before: list[str] = []
            line = field.lineno - 1
            while line in above:
                before.insert(0, above[line])
                line -= 1
            assert field.end_lineno is not None
            words = " ".join([*before, *([beside[field.end_lineno]] if field.end_lineno in beside else [])])
            if words:
                found[field.target.id] = words
    return found


def _by_line(source: str) -> tuple[dict[int, str], dict[int, str]]:
    """Return the comments behind code and those that have a line of their own, by line."""
    beside: dict[int, str] = {}
    above: dict[int, str] = {}
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            alone = not token.line[: token.start[1]].strip()
            (above if alone else beside)[token.start[0]] = token.string.lstrip("#: ")
    return beside, above
