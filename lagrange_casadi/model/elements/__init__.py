"""Parts as they are built, each declared in one call and made of links, joints and loads."""
