#include "haptics/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kPlain = kernels_named("plain");

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
  return kernels_of<ContactKernels>(set,
                                    {&kPlain, avx2_contact_kernels(), avx512_contact_kernels()});
}

const ContactKernels& contact_kernels() noexcept {
  static const ContactKernels& fastest = fastest_kernels(contact_kernels_of);
  return fastest;
}

}  // namespace sulcus
