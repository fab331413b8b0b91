"""Common parts of all Rerun layouts: see live_blueprint and result_layout."""

import rerun.blueprint as rrb

BACKGROUND = (20, 23, 27)
ORBIT_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 106), y_range=(-12, 116))
BODE_BOUNDS = rrb.VisualBounds2D(x_range=(-18, 194), y_range=(-11, 117))
POLAR_BOUNDS = rrb.VisualBounds2D(x_range=(-20, 120), y_range=(-22, 120))


def flat(origin: str, name: str, bounds: rrb.VisualBounds2D) -> rrb.Spatial2DView:
    """Return a view of a drawing that opens showing `bounds`."""
    return rrb.Spatial2DView(origin=origin, name=name, background=BACKGROUND, visual_bounds=bounds)


def make_blueprint(root: rrb.Container, *, timeline: str, fps: float | None = None) -> rrb.Blueprint:
    """Return a blueprint of these views alone, the viewer's own panels out of the way.

    `fps` is how many steps of a timeline without seconds are played in one.
    """
    return rrb.Blueprint(
        root,
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline=timeline, fps=fps),
        auto_views=False,
        auto_layout=False,
    )
