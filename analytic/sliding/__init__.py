"""The block that may slide: Coulomb friction between the block and its support."""
