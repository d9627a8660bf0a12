// The random stream of Gymnasium's np_random: numpy's Generator over PCG64 (XSL-RR 128/64).
#pragma once

#include <cstdint>
#include <optional>

namespace neol {

class Pcg64 {
 public:
  Pcg64() = default;

  // `state` as numpy's PCG64(seed).state tells it: state and increment, each high word first.
  explicit Pcg64(const std::uint64_t state[4])
      : state_(word(state[0], state[1])), increment_(word(state[2], state[3])) {}

  // Generator.random: uniform in [0, 1), 53 bits.
  double random() { return static_cast<double>(next() >> 11) * (1.0 / 9007199254740992.0); }

  // Generator.uniform.
  double uniform(double low, double high) { return low + (high - low) * random(); }

  // Generator.integers(low, high), high excluded: Lemire's method on 32-bit draws. A range of one
  // number draws nothing.
  int integers(int low, int high) {
    const auto range = static_cast<std::uint32_t>(high - low);
    if (range == 1) return low;
    const std::uint32_t threshold = (0u - range) % range;
    std::uint64_t product;
    do {
      product = std::uint64_t{next_half()} * range;
    } while (static_cast<std::uint32_t>(product) < threshold);
    return low + static_cast<int>(product >> 32);
  }

 private:
  __extension__ using Word = unsigned __int128;

  static constexpr Word word(std::uint64_t high, std::uint64_t low) {
    return Word{high} << 64 | low;
  }

  std::uint64_t next() {
    constexpr Word multiplier = word(0x2360ED051FC65DA4, 0x4385DF649FCCF645);
    state_ = state_ * multiplier + increment_;
    const auto folded =
        static_cast<std::uint64_t>(state_ >> 64) ^ static_cast<std::uint64_t>(state_);
    const auto rotation = static_cast<unsigned>(state_ >> 122);
    return folded >> rotation | folded << (-rotation & 63);
  }

  // 32-bit draws take the lower half of a 64-bit draw, then its upper half.
  std::uint32_t next_half() {
    if (upper_half_) {
      const std::uint32_t half = *upper_half_;
      upper_half_.reset();
      return half;
    }
    const std::uint64_t draw = next();
    upper_half_ = static_cast<std::uint32_t>(draw >> 32);
    return static_cast<std::uint32_t>(draw);
  }

  Word state_ = 0;
  Word increment_ = 0;
  std::optional<std::uint32_t> upper_half_;
};

}  // namespace neol
