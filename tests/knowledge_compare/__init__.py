"""What the comparison knows, case by case, at the level of its verdict; the rules: docs/reference/rules_compare.md."""
