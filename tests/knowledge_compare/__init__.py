"""What the comparison knows, case by case, at the level of its verdict; docs/reference/rules_compare.md has the rules."""
