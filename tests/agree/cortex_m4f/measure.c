/* What the functions of an exported mechanism take on the machine: instructions, and bytes of stack and of the structs.

   MECHANISM is its prefix; SETTINGS, RESTS and LINKS tell its interface; START and STEP [s] give the instants. */
#include <stdint.h>
#include <stdio.h>

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define OF(word) JOIN(MECHANISM, word)
#define TEXT_(word) #word
#define TEXT(word) TEXT_(word)
#include TEXT(MECHANISM.h)

#define INSTANTS 64
#define PAINTED 8192
#define PAINT 0xA5A5A5A5u
/* With one instruction a nanosecond, and a core of 25 MHz, a tick is as many instructions. */
#define TICK 40

#define CONTROL (*(volatile uint32_t*) 0xE000E010)
#define RELOAD (*(volatile uint32_t*) 0xE000E014)
#define CURRENT (*(volatile uint32_t*) 0xE000E018)

static OF(_model) model;
static OF(_inputs) inputs[INSTANTS];
static OF(_outputs) outputs[INSTANTS];
static int bad = 0;

static uint32_t since(uint32_t before) {
  return ((before - CURRENT) & 0xFFFFFFu)*TICK;
}

static void expect_well(int status) {
  bad += status != 0;
}

static void prepare(void) {
#if SETTINGS
  expect_well(OF(_prepare)(&model, 0));
#else
  expect_well(OF(_prepare)(&model));
#endif
}

static void all_preparations(void) {
  int k;
  for (k = 0; k < INSTANTS; ++k) prepare();
}

static void motion(int k) {
  const OF(_real) time = (OF(_real)) (START) + (OF(_real)) k*(OF(_real)) (STEP);
#if RESTS
  expect_well(OF(_motion)(&model, time, 0, inputs + k));
#else
  expect_well(OF(_motion)(&model, time, inputs + k));
#endif
}

static void all_motions(void) {
  int k;
  for (k = 0; k < INSTANTS; ++k) motion(k);
}

static void all_evaluations(void) {
  int k;
  for (k = 0; k < INSTANTS; ++k) expect_well(OF(_evaluate)(&model, inputs + k, outputs + k));
}

static void batch(void) {
  expect_well(OF(_batch)(&model, INSTANTS, inputs, outputs, 0));
}

#if LINKS
static OF(_forces) forces[3];

static void all_sections(void) {
  static const OF(_real) ratios[3] = {0, (OF(_real)) 0.5, 1};
  int k, link;
  for (k = 0; k < INSTANTS; ++k) {
    for (link = 0; link < LINKS; ++link) expect_well(OF(_sections)(&model, outputs + k, (OF(_link)) link, 3, ratios, forces));
  }
}
#endif

static void known(void) {
  uint32_t count = 100000;
  __asm volatile("1: subs %0, #1\n\tbne 1b" : "+r"(count) : : "cc");
}

/* Bytes below here that a call writes to. Not inlined, for its frame must end above what it paints. */
__attribute__((noinline)) static uint32_t stack_of(void (*call)(void)) {
  register char* here __asm("sp");
  volatile uint32_t* const top = (volatile uint32_t*) here;
  volatile uint32_t* lowest = top - PAINTED/4;
  volatile uint32_t* word;
  for (word = lowest; word < top; ++word) *word = PAINT;
  call();
  for (word = lowest; word < top && *word == PAINT; ++word) continue;
  return (uint32_t) (here - (char*) word);
}

static void nothing(void) {
}

static uint32_t instructions_of(void (*call)(void)) {
  const uint32_t before = CURRENT;
  call();
  return since(before);
}

int main(void) {
  uint32_t worst = 0;
  int k;
  RELOAD = 0xFFFFFFu;
  CURRENT = 0;
  CONTROL = 5;
  printf("instructions known %lu\n", (unsigned long) instructions_of(known));
  printf("instructions prepare %lu\n", (unsigned long) instructions_of(all_preparations)/INSTANTS);
  printf("instructions motion %lu\n", (unsigned long) instructions_of(all_motions)/INSTANTS);
  printf("instructions evaluate %lu\n", (unsigned long) instructions_of(all_evaluations)/INSTANTS);
  prepare();
  for (k = 0; k < INSTANTS; ++k) {
    const uint32_t before = CURRENT;
    uint32_t taken;
    expect_well(OF(_evaluate)(&model, inputs + k, outputs + k));
    taken = since(before);
    if (taken > worst) worst = taken;
  }
  printf("instructions worst %lu\n", (unsigned long) worst);
#if LINKS
  printf("instructions section %lu\n", (unsigned long) instructions_of(all_sections)/(INSTANTS*LINKS*3));
  printf("stack sections %lu\n", (unsigned long) stack_of(all_sections));
#endif
  printf("stack nothing %lu\n", (unsigned long) stack_of(nothing));
  printf("stack prepare %lu\n", (unsigned long) stack_of(prepare));
  printf("stack motion %lu\n", (unsigned long) stack_of(all_motions));
  printf("stack evaluate %lu\n", (unsigned long) stack_of(batch));
  printf("bytes model %u\n", (unsigned) sizeof model);
  printf("bytes inputs %u\n", (unsigned) sizeof inputs[0]);
  printf("bytes outputs %u\n", (unsigned) sizeof outputs[0]);
  return bad != 0;
}
