"""Foundation that knows no finger: errors, files, sets of files, TOML, progress, numerics, compiled loops."""
