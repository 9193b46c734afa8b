#include "engine/recording/tick_record.hpp"

#include <cstddef>

#include "engine/core/hash.hpp"

namespace sulcus {

void seal(TickRecord& record) { record.check = hash_bytes(&record, offsetof(TickRecord, check)); }

void seal(CuttingRecord& record) {
  record.check = hash_bytes(&record, offsetof(CuttingRecord, check));
}

bool is_sealed(const CuttingRecord& record) {
  return record.check == hash_bytes(&record, offsetof(CuttingRecord, check));
}

bool is_sealed(const TickRecord& record) {
  return record.check == hash_bytes(&record, offsetof(TickRecord, check));
}

}  // namespace sulcus
