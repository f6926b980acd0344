"""Map readers: one module each, with a YAML file each in ``conf/map``."""
