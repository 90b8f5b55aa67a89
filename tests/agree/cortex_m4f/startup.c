/* Begins a program on a bare Cortex-M4F whose output, and exit, go through semihosting. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

extern char data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

void initialise_monitor_handles(void);
void _exit(int status);
int main(void);
void reset(void);
void _fini(void);

/* What the C library calls at the end of a program. */
void _fini(void) {
}

static void fault(void) {
  _exit(3);
}

void reset(void) {
  /* The floating-point unit sleeps after a reset; underflow stays gradual, and nothing traps. */
  *(volatile uint32_t*) 0xE000ED88 |= 0xFu << 20;
  __asm volatile("dsb\n\tisb" ::: "memory");
  memcpy(data_begin, data_from, (size_t) (data_end - data_begin));
  memset(bss_begin, 0, (size_t) (bss_end - bss_begin));
  initialise_monitor_handles();
  exit(main());
}

__attribute__((section(".vectors"), used)) static const void* const vectors[16] = {
  stack_top, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault
};
