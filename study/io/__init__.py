"""Files in and out: waypoints and limits as other programs write them, motions as other programs read them."""
