"""The equations at a state: derivatives, identities, forces, reactions, contacts, beams."""
