"""Auto-scaling of a plot to its data, in round numbers and not at every frame."""

from rotorrig.app.plot_data import nice

SHRINK = 0.3  # of the scale: what is smaller than this gets a smaller one


class FollowingScale:
    """Half the height of an axis about zero: grows at once, shrinks when most of it has become empty."""

    def __init__(self, smallest: float) -> None:
        self.value = smallest
        self._smallest = smallest

    def follow(self, reach: float) -> bool:
        """Take the largest value to be drawn; return whether the scale has changed."""
        before = self.value
        if reach > self.value or self._smallest < reach < SHRINK * self.value:
            self.value = max(nice(1.05 * reach), self._smallest)
        return self.value != before
