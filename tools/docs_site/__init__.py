"""Site of the documentation: configuration of mkdocs, generated pages and pictures."""
