#include "engine/graphics/egl_context.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::egl_context_test {
namespace {

TEST(EglContext, SaysWhatWasTried) {
  const std::vector<EglPlatform> none;
  EXPECT_THROW(EglContext{none}, std::runtime_error);
  // Whichever of the other two ways exists here must work, or say its name.
  for (const EglPlatform platform : {EglPlatform::kDevice, EglPlatform::kDefault}) {
    const EglPlatform only[] = {platform};
    try {
      const EglContext context(only);
      EXPECT_NE(context.description().find("OpenGL"), std::string::npos);
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.find("EGL device") != std::string::npos ||
                  what.find("default display") != std::string::npos)
          << what;
    }
  }
}

}  // namespace
}  // namespace sulcus::egl_context_test
