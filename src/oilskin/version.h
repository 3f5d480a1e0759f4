/// @file
/// The version of Oilskin. CMake reads the three numbers from this file; they stand nowhere else.
#pragma once

/// The major number.
#define OILSKIN_VERSION_MAJOR 0
/// The minor number.
#define OILSKIN_VERSION_MINOR 1
/// The patch number.
#define OILSKIN_VERSION_PATCH 0

#define OILSKIN_DETAIL_QUOTE(x) #x
#define OILSKIN_DETAIL_VERSION(major, minor, patch) \
  OILSKIN_DETAIL_QUOTE(major) "." OILSKIN_DETAIL_QUOTE(minor) "." OILSKIN_DETAIL_QUOTE(patch)
/// The version of the headers as text, such as "1.2.3".
#define OILSKIN_VERSION_STRING \
  OILSKIN_DETAIL_VERSION(OILSKIN_VERSION_MAJOR, OILSKIN_VERSION_MINOR, OILSKIN_VERSION_PATCH)

namespace oilskin {

/// A version number; versions that differ in the minor number before 1.0 are not compatible.
struct Version {
  /// The major number.
  int major = 0;
  /// The minor number.
  int minor = 0;
  /// The patch number.
  int patch = 0;

  /// Whether all three numbers are equal.
  bool operator==(const Version& o) const { return major == o.major && minor == o.minor && patch == o.patch; }
  /// Whether a number differs.
  bool operator!=(const Version& o) const { return !(*this == o); }
};

/// The version of these headers.
inline constexpr Version header_version = {OILSKIN_VERSION_MAJOR, OILSKIN_VERSION_MINOR,
                                           OILSKIN_VERSION_PATCH};

/// The version of the library that the program is linked to. If it differs from header_version, the headers
/// and the library are of two installations.
Version version();

}  // namespace oilskin
