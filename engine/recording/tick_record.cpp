#include "engine/recording/tick_record.hpp"

#include <cstddef>

#include "engine/core/hash.hpp"

namespace sulcus {

namespace {

template <class Row>
std::uint64_t check_of(const Row& row) {
  return hash_bytes(&row, offsetof(Row, check));
}

}  // namespace

void seal(TickRecord& record) { record.check = check_of(record); }

void seal(CuttingRecord& record) { record.check = check_of(record); }
void seal(PortRecord& record) { record.check = check_of(record); }
void seal(PieceRow& row) { row.check = check_of(row); }
void seal(PiecePoseRow& row) { row.check = check_of(row); }
void seal(TakenAnswerRow& row) { row.check = check_of(row); }

bool is_sealed(const TickRecord& record) { return record.check == check_of(record); }
bool is_sealed(const CuttingRecord& record) { return record.check == check_of(record); }
bool is_sealed(const PortRecord& record) { return record.check == check_of(record); }
bool is_sealed(const PieceRow& row) { return row.check == check_of(row); }
bool is_sealed(const PiecePoseRow& row) { return row.check == check_of(row); }
bool is_sealed(const TakenAnswerRow& row) { return row.check == check_of(row); }

}  // namespace sulcus
