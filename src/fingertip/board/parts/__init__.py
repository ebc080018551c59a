"""Parts table: manufacturer's and distributor's number of each component that can be bought, with its source."""
