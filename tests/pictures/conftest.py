"""Champions to draw and film: records of tiny runs, made once."""

from tests.champions.conftest import player_of as player_of
from tests.champions.conftest import record_of as record_of
