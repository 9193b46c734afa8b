#include "haptics/contact/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kPlain = kernels_named("plain");

}  // namespace

ContactArrays arrays_of(Contacts& contacts, std::size_t first) noexcept {
  ContactArrays arrays;
  arrays.size = contacts.size() - first;
  arrays.keys = contacts.keys() + first;
  arrays.tissues = contacts.tissues() + first;
  for (std::size_t q = 0; q < Contacts::kQuantities; ++q) arrays.of[q] = contacts(q) + first;
  return arrays;
}

BlockArrays arrays_of(ContactBlock& block, std::size_t first) noexcept {
  BlockArrays arrays;
  for (std::size_t q = 0; q < ContactBlock::kQuantities; ++q) {
    arrays.of[q] = block(q) + (first - block.first());
  }
  return arrays;
}

MeasureSums sums_of(const MeasureLanes& lanes) noexcept {
  const auto sum = [](const double(&of)[kSumLanes]) { return sum_of(load(of)); };
  MeasureSums sums;
  sums.weights = sum(lanes.weights);
  sums.energy = sum(lanes.energy);
  sums.counted = lanes.counted;
  sums.deepest_m = lanes.deepest_m;
  sums.spread.weight = sum(lanes.near);
  for (int a = 0; a < 3; ++a) sums.spread.normal[a] = sum(lanes.normal[a]);
  for (int entry = 0; entry < 6; ++entry) sums.spread.products[entry] = sum(lanes.products[entry]);
  return sums;
}

const ContactKernels* contact_kernels_of(InstructionSet set) noexcept {
  return kernels_of<ContactKernels>(set,
                                    {&kPlain, avx2_contact_kernels(), avx512_contact_kernels()});
}

const ContactKernels& contact_kernels() noexcept {
  static const ContactKernels& fastest = fastest_kernels(contact_kernels_of);
  return fastest;
}

}  // namespace sulcus
