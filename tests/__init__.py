"""The tests of nullbody."""
