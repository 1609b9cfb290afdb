"""What several studies draw or run: statues in the promised range, and motions of the ground."""
