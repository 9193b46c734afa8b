#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <hdf5.h>

namespace sulcus {

// Inside this folder only: no public header includes it, so that nobody else sees HDF5.

/// A call of HDF5 failed. `what()` is one line; whoever knows the file adds its path.
class Hdf5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is stored in a way that is not read: no damage.
class UnreadLayout : public Hdf5Error {
 public:
  using Hdf5Error::Hdf5Error;
};

/// Owns one HDF5 identifier.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Handle() { close(); }

  operator hid_t() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// Leaves it open for good: HDF5 1.10.8 must not be asked to close what it could not write.
  void release() { id_ = H5I_INVALID_HID; }
  /// Closes now; false where HDF5 could not (a file whose last bytes found no room).
  bool close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Every public entry of ours calls this first. Stops HDF5 from printing its error stack (which is
/// the thread's own), and from cleaning up at exit, where 1.10.8 crashes over a file that a full
/// disk kept it from closing.
void silence_hdf5();

/// Why the last call failed, in a few words: the system's message where there is one, else what
/// HDF5 says at the innermost of its error stack.
std::string hdf5_reason();

/// Takes the identifier, or throws Hdf5Error "WHAT: reason".
Hdf5Handle hdf5_checked(hid_t id, Hdf5Handle::Close closer, const char* what);

/// Throws Hdf5Error "WHAT: reason" where `status` is negative.
void hdf5_check(herr_t status, const char* what);

}  // namespace sulcus
