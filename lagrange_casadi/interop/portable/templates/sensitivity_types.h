
/* How an output changes with parameters. */
typedef struct {
$rows
} ${p}_changes;

/* How the outputs change, each by its own name. */
typedef struct {
$members
} ${p}_sensitivities;
