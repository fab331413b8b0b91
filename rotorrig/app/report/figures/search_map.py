"""Where a global search looked: points, the best of every cluster and the minima, over two unknowns at a time."""

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from rotorrig.app.report.figures.look import COLOURS, SHEER, apply_look
from rotorrig.app.text import SHOWN
from rotorrig.identify import Fit

HEIGHT = 330  # px


def search_map(fit: Fit) -> go.Figure | None:
    """Return the search of a fit; None if it had a single unknown or left no trace."""
    trace, known = fit.trace, fit.trace.points.shape[1]  # the vector's search solves for the amounts
    if known < 2:
        return None
    pairs = [(i, i + 1) for i in range(0, known - 1, 2)] + ([(0, known - 1)] if known % 2 else [])
    figure = make_subplots(rows=1, cols=len(pairs), horizontal_spacing=0.09)
    shown = [SHOWN.get(fit.estimate(name).unit, (fit.estimate(name).unit, 1.0)) for name in fit.unknowns]
    refined = [fit.estimate(name).value for name in fit.unknowns]
    looks = (
        ("evaluated", trace.points, {"size": 3.5, "color": SHEER[0]}),
        ("best of a cluster", trace.heads, {"size": 7, "color": COLOURS[+1], "symbol": "diamond-open"}),
        ("minimum", [o.theta for o in fit.optima], {"size": 10, "color": COLOURS[-1], "symbol": "cross-open"}),
        (
            "refined",
            [refined],
            {"size": 11, "color": "#b3123b", "symbol": "circle-open"},
        ),
    )
    for column, (i, j) in enumerate(pairs, start=1):
        for name, places, marker in looks:
            x, y = ([float(place[k]) * shown[k][1] for place in places] for k in (i, j))
            dots = go.Scatter(
                x=x, y=y, name=name, mode="markers", marker=marker, legendgroup=name, showlegend=column == 1
            )
            figure.add_trace(dots, row=1, col=column)
        for k, update in ((i, figure.update_xaxes), (j, figure.update_yaxes)):
            positive = bool((trace.points[:, k] > 0).all())
            title = f"{fit.unknowns[k]} [{shown[k][0]}]"
            update(title_text=title, type="log" if positive else "linear", row=1, col=column)
    return apply_look(figure, height=HEIGHT)
