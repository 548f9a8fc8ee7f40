"""What has inertia: links, beams, rotors."""
