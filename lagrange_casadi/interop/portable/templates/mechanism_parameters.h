
/* Numbers that may change without generating anything again.
   $corners */
typedef struct {
$rows
} ${p}_parameters;

extern const ${p}_parameters ${p}_defaults;
