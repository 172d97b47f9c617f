"""Blends: rounded edges as R-systems, added and removed material, fillets that say what they guarantee."""
