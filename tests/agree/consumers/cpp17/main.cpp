// The same as the C99 consumer, by the functions for many instants and many ratios.
#include MECHANISM
#include NAMES

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(word) JOIN(P, word)

static void check(NAME(status) status) {
  if (status) throw std::runtime_error(NAME(message)(status));
}

int main(int count, char** words) try {
  NAME(model) model;
  check(PREPARE(&model));
  std::vector<NAME(inputs)> inputs;
  for (double t, rest; std::scanf("%lf %lf", &t, &rest) == 2;) {
    inputs.emplace_back();
    check(NAME(motion)(&model, TIME(t, rest), &inputs.back()));
  }
  std::vector<NAME(outputs)> outputs(inputs.size());
  std::vector<NAME(status)> statuses(inputs.size());
  check(NAME(batch)(&model, static_cast<long>(inputs.size()), inputs.data(), outputs.data(), statuses.data()));
  std::vector<NAME(real)> ratios;
  for (int k = 1; k < count; ++k) ratios.push_back(static_cast<NAME(real)>(std::atof(words[k])));
  for (auto const& at : outputs) {
#define X(member) std::printf("%a ", static_cast<double>(at.member));
    OUTPUTS(X)
#undef X
#define X(link) \
    { \
      std::vector<NAME(forces)> forces(ratios.size()); \
      check(NAME(sections)(&model, &at, link, static_cast<long>(ratios.size()), ratios.data(), forces.data())); \
      for (auto const& here : forces) { \
        std::printf("%a %a %a ", static_cast<double>(here.axial), static_cast<double>(here.shear), static_cast<double>(here.bending)); \
      } \
    }
    LINKS(X)
#undef X
    std::printf("\n");
  }
  return 0;
} catch (std::exception const& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
