/* What a layout of C structs is claimed by: where each field lies, how large a struct is, what a constant is. A file of
 * claims defines LAYOUT_OF(type), how its header names a struct, and includes this. */
#include <stddef.h>

#ifdef __cplusplus
#define HOLDS(name, condition) static_assert(condition, #name)
#else /* C99 has no static_assert */
#define HOLDS(name, condition) typedef char name[(condition) ? 1 : -1]
#endif
#define AT(type, field, offset, size) \
  HOLDS(type##_##field##_has_moved,   \
        offsetof(LAYOUT_OF(type), field) == (offset) && sizeof(((LAYOUT_OF(type)*)NULL)->field) == (size))
#define SIZE(type, size) HOLDS(type##_has_another_size, sizeof(LAYOUT_OF(type)) == (size))
#define IS(constant, value) HOLDS(constant##_has_another_value, (constant) == (value))
