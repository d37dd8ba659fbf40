; 2:9-10 E0210 `Z` must be alone in its string;
G00X1Y1 Z5;
