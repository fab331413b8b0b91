"""The drawings show the config's own millimetres and its sense of rotation."""

from xml.etree import ElementTree

from rotorrig.app.report.drawings.rig_drawing import end_view, side_view
from rotorrig.rig.config.description import RigConfig


def test_the_rig_is_drawn_to_scale(rig: RigConfig) -> None:
    drawing = ElementTree.fromstring(side_view(rig))
    (disk,) = [e for e in drawing.iter() if e.get("class") == "disk" and e.tag == "rect"]
    assert [float(disk.get(k, "")) for k in ("x", "width", "height")] == [268.0, 25.0, 75.0]  # 280.5 less half of 25
    words = [e.text for e in drawing.iter("text")]
    for label in ("left A, 65", "left B, 80", "spring, 481", "1x, 1y, 250.5", "2x, 2y, 380.5", "disk, 280.5"):
        assert label in words


def test_a_found_place_is_ringed_and_named(rig: RigConfig) -> None:
    drawing = ElementTree.fromstring(side_view(rig, marked=[(0.481, "friction")]))
    (ring,) = [e for e in drawing.iter("ellipse") if e.get("class") == "found"]
    assert float(ring.get("cx", "")) == 481.0
    assert "friction" in [e.text for e in drawing.iter("text")]
    assert drawing.get("aria-label", "").endswith("friction at 481 mm.")


def test_the_end_view_turns_as_the_config_says(rig: RigConfig) -> None:
    def sweep_flag(drawing: str) -> str:
        (arc,) = [e for e in ElementTree.fromstring(drawing).iter() if "A27 " in e.get("d", "")]
        return arc.get("d", "").split()[5]  # M x y A rx ry rotation large-arc sweep

    assert sweep_flag(end_view(rig)) == "0"  # anticlockwise on paper: x to the right, y up
    assert sweep_flag(end_view(rig.model_copy(update={"rotation": "y-to-x"}))) == "1"
