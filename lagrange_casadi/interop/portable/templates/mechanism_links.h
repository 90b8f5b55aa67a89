
typedef enum {
$links
} ${p}_link;

/* What the part towards the tip does to the part towards the base. */
typedef struct {
$forces
} ${p}_forces;
