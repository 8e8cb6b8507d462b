def level() -> int:
    """Level of x86-64 that this CPU has, 1 to 4; 0: another family."""
