#include "engine/core/instruction_set.hpp"
#include "haptics/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kPlain{"plain",     find_near, leaf_distances_of,
                                measure_all, turn_all,  forces_of};

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

const ContactKernels& plain_contact_kernels() noexcept { return kPlain; }

const ContactKernels& contact_kernels() noexcept {
  static const ContactKernels& fastest =
      use_avx2() && avx2_contact_kernels() ? *avx2_contact_kernels() : kPlain;
  return fastest;
}

}  // namespace sulcus
