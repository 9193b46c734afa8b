#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <elf.h>
#include <link.h>

#include "engine/cache/load_cache.hpp"

namespace sulcus {
namespace {

/// Bytes of the NT_GNU_BUILD_ID note of a loaded object; empty where it has none.
std::span<const std::byte> build_id_of(const dl_phdr_info& object) {
  const auto padded = [](std::size_t bytes) { return (bytes + 3) & ~std::size_t{3}; };
  for (int p = 0; p < object.dlpi_phnum; ++p) {
    const auto& segment = object.dlpi_phdr[p];
    if (segment.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const std::byte*>(object.dlpi_addr + segment.p_vaddr);
    for (std::size_t left = segment.p_memsz; left >= sizeof(ElfW(Nhdr));) {
      ElfW(Nhdr) note;
      std::memcpy(&note, at, sizeof note);
      const std::size_t size = sizeof note + padded(note.n_namesz) + padded(note.n_descsz);
      if (size > left) break;
      if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 &&
          std::memcmp(at + sizeof note, "GNU", 4) == 0) {
        return {at + sizeof note + 4, note.n_descsz};
      }
      at += size;
      left -= size;
    }
  }
  return {};
}

struct Ids {
  std::vector<std::byte> bytes;
  bool first = true, program_has_one = false;
};

int collect(dl_phdr_info* object, std::size_t, void* data) {
  auto& ids = *static_cast<Ids*>(data);
  const std::span<const std::byte> id = build_id_of(*object);
  // The program itself comes first. The kernel's page of code makes nothing that is kept.
  if (ids.first) ids.program_has_one = !id.empty();
  ids.first = false;
  if (std::string_view(object->dlpi_name).starts_with("linux-vdso")) return 0;
  ids.bytes.insert(ids.bytes.end(), id.begin(), id.end());
  return 0;
}

}  // namespace

std::optional<Hash128> program_id() {
  static const std::optional<Hash128> id = []() -> std::optional<Hash128> {
    Ids ids;
    dl_iterate_phdr(collect, &ids);
    if (!ids.program_has_one) return std::nullopt;
    return Hash128Stream().add_bytes(ids.bytes.data(), ids.bytes.size()).result();
  }();
  return id;
}

}  // namespace sulcus
