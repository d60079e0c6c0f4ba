#include "picture/canvas.hpp"

namespace asperity::picture {

pixmap canvas::finish(const colour& background) const {
  constexpr float share = 1.0F / (fineness * fineness);
  pixmap out{width_ / fineness, height_ / fineness, {}};
  out.rgb.reserve(3 * out.width * out.height);
  for (std::size_t y = 0; y < height_; y += fineness) {
    for (std::size_t x = 0; x < width_; x += fineness) {
      colour sum;
      for (std::size_t j = y; j < y + fineness; ++j) {
        for (std::size_t i = j * width_ + x; i < j * width_ + x + fineness; ++i) {
          sum = sum + (near_[i] > -std::numeric_limits<float>::infinity() ? colour_[i] : background);
        }
      }
      for (const float channel : {sum.r, sum.g, sum.b}) out.rgb.push_back(to_srgb8(share * channel));
    }
  }
  return out;
}

}  // namespace asperity::picture
