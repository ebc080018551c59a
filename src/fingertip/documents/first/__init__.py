"""Documents of a finger whose skin is cast around a lowered core: sheet, things to buy, first screen, acceptance."""
