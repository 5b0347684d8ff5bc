// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/codec/tree_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace lucerna {

namespace {

/// floor(log2(rays)) from the bits of the number: no rounding that machines could disagree on.
std::uint32_t log2_of(double rays) {
  const auto exponent = static_cast<int>(std::bit_cast<std::uint64_t>(rays) >> 52 & 0x7FF) - 1023;
  return static_cast<std::uint32_t>(std::clamp(exponent + 1, 0, 31));
}

}  // namespace

/// Both directions of one description: each call codes `x`, or sets it.
struct TreeCodec::Encode {
  RangeEncoder* coder;
  void bit(AdaptiveBit& model, bool& x) { coder->bit(model, x); }
  template <unsigned Bits>
  void symbol(AdaptiveSymbol<Bits>& model, std::uint32_t& x) {
    model.encode(*coder, x);
  }
};

struct TreeCodec::Decode {
  RangeDecoder* coder;
  void bit(AdaptiveBit& model, bool& x) { x = coder->bit(model); }
  template <unsigned Bits>
  void symbol(AdaptiveSymbol<Bits>& model, std::uint32_t& x) {
    x = model.decode(*coder);
  }
};

template <class Side>
void TreeCodec::node(Side& side, TreeNode& n, const Context& c, std::uint64_t tree_number) {
  bool split = !n.is_leaf();
  side.bit(split_[c.size][c.axis_above == 4 ? 0 : c.upper ? 1 : 2], split);
  n.right = split ? 1 : 0;
  if (!split) return;
  std::uint32_t axis = n.axis;
  side.symbol(axis_[c.axis_above], axis);
  n.axis = static_cast<std::uint8_t>(axis);
  // Cuts are 1 + offset + 4 k in small nodes: the low bits, less the offset, are mostly zero there.
  const std::uint32_t offset = cut_offset(tree_number, c.path, axis), shifted = n.cut + 63u - offset;
  std::uint32_t low = shifted & 3u, high = shifted >> 2 & 15u;
  side.symbol(fine_cut_[axis][c.size > 14 ? 1 : 0], low);
  side.symbol(cut_[axis], high);
  n.cut = static_cast<std::uint8_t>((low + 4 * high + 1 + offset) & 63u);
  bool empty = n.step == kLeftEmpty || n.step == kRightEmpty, right = n.step == kRightEmpty;
  side.bit(empty_[axis][0], empty);
  if (empty) {
    side.bit(empty_[axis][1], right);
    n.step = right ? kRightEmpty : kLeftEmpty;
    return;
  }
  // Steps 0, +-1, +-2..3, +-4..7 ...: the length in unary, then the bits below the first.
  bool negative = n.step < 0;
  const auto magnitude = static_cast<std::uint32_t>(std::abs(n.step));
  std::uint32_t length = static_cast<std::uint32_t>(std::bit_width(magnitude)), coded = 0;
  for (; coded < 12; ++coded) {
    bool more = coded < length;
    side.bit(length_[axis][coded], more);
    if (!more) break;
  }
  std::uint32_t value = coded > 0 ? 1u : 0u;
  for (std::uint32_t i = coded; i-- > 1;) {
    bool one = (magnitude >> (i - 1) & 1u) != 0;
    side.bit(coded - i < 2 ? mantissa_[axis][coded][coded - i] : rest_[i], one);
    value = value << 1 | (one ? 1u : 0u);
  }
  if (value != 0) side.bit(sign_[axis][c.upper ? 1 : 0], negative);
  n.step = static_cast<std::int16_t>(negative ? -static_cast<int>(value) : static_cast<int>(value));
}

TreeCodec::Context TreeCodec::root(double rays) { return {kRootPath, rays, log2_of(rays), 4, false}; }

TreeCodec::Context TreeCodec::child(const Context& c, const TreeNode& n, bool upper) {
  const double left = tree_share(n, c.rays), rays = c.rays * (upper ? 1.0 - left : left);
  return {child_path(c.path, upper), rays, log2_of(rays), n.axis, upper};
}

void TreeCodec::encode(RangeEncoder& coder, const DensityTree& tree, std::uint64_t tree_number) {
  Encode side{&coder};
  std::vector<Context> stack{root(tree.rays)};
  for (const TreeNode& stored : tree.nodes) {
    const Context c = stack.back();
    stack.pop_back();
    TreeNode n = stored;
    node(side, n, c, tree_number);
    if (stored.is_leaf()) continue;
    stack.push_back(child(c, stored, true));
    stack.push_back(child(c, stored, false));
  }
}

bool TreeCodec::decode(RangeDecoder& coder, double rays, std::uint64_t tree_number, std::size_t max_nodes,
                       std::vector<TreeNode>& nodes) {
  Decode side{&coder};
  struct Pending {
    Context context;
    std::size_t parent;
  };
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<Pending> stack{{root(rays), kNone}};
  nodes.clear();
  while (!stack.empty()) {
    const Pending p = stack.back();
    stack.pop_back();
    if (nodes.size() >= max_nodes || coder.overrun()) return false;
    const std::size_t self = nodes.size();
    if (p.parent != kNone) nodes[p.parent].right = static_cast<std::uint32_t>(self - p.parent);
    TreeNode& n = nodes.emplace_back();
    node(side, n, p.context, tree_number);
    if (n.is_leaf()) continue;
    if (n.cut == 0 || n.cut >= kTreeCuts) return false;
    stack.push_back({child(p.context, n, true), self});
    stack.push_back({child(p.context, n, false), kNone});
  }
  return !coder.overrun();
}

}  // namespace lucerna
