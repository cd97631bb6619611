"""Expert motion: clips, the controller that makes them, the data set, exchange with other formats."""
