"""Blends: rounded edges as R-systems, added and removed material, fillets that say what they guarantee.

Two shapes and a size come in; one shape goes out, its edge rounded.

- `folds`: what blends that are R-operations share; `rho` and `sardf` are two such systems
- `operands`: shapes and expressions with their letters; `fillets` and `displacement` blend them
- `gates`: blends taken apart for meshes, for the sign alone
"""
