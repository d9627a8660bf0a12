"""How a batch is cut into pieces for many workers."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from neol.rollout.parallel import portions


@given(networks=st.integers(0, 400), workers=st.integers(1, 70))
def test_portions_cover_a_batch_in_order(networks: int, workers: int) -> None:
    bounds = [0, *(end for _, end in portions(networks, workers))]
    assert portions(networks, workers) == list(pairwise(bounds))
    assert bounds[-1] == networks


def test_portions_shrink_towards_the_end() -> None:
    sizes = [end - begin for begin, end in portions(50, 2)]
    assert sizes == [8, 8, 8, 6, 5, 3, 3, 2, 1, 1, 1, 1, 1, 1, 1]
