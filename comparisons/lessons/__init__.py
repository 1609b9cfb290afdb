"""Teaching material: the playground, a page that lets one play with the rocking block, and what stands around it."""
