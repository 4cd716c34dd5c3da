protocol empty "Nothing to compare"
