#include "haptics/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kPlain{"plain",   leaf_keys_of, find_near, leaf_distances_of,
                                take_kept, measure_all,  turn_all,  forces_of};

}  // namespace

ContactArrays arrays_of(Contacts& contacts) noexcept {
  ContactArrays arrays;
  arrays.size = contacts.size();
  arrays.keys = contacts.keys();
  arrays.tissues = contacts.tissues();
  for (std::size_t q = 0; q < Contacts::kQuantities; ++q) {
    arrays.of[q] = contacts(Contacts::Quantity(q));
  }
  return arrays;
}

const ContactKernels* contact_kernels_of(InstructionSet set) noexcept {
  if (!has(set)) return nullptr;
  switch (set) {
    case InstructionSet::kAvx512:
      return avx512_contact_kernels();
    case InstructionSet::kAvx2:
      return avx2_contact_kernels();
    case InstructionSet::kPlain:
      break;
  }
  return &kPlain;
}

const ContactKernels& contact_kernels() noexcept {
  static const ContactKernels& fastest = fastest_kernels(contact_kernels_of);
  return fastest;
}

}  // namespace sulcus
