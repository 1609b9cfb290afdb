"""Teaching material: lessons as pages and notebooks, and the playground, a page that simulates the rocking block."""
