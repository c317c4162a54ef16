"""Speed, ours beside the peers' on the same work in the same run; never part of the tests."""
