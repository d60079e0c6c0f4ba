// Contacts that a force model reports of its own accord, because its finder knows none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity {

/// Room for a fixed number of contacts with their depths, taken when it is made.
class reported_contacts {
 public:
  static constexpr std::size_t most = 64;

  reported_contacts() {
    detail::reserve_resident(contacts_, most);
    detail::reserve_resident(depths_, most);
  }

  /// @rt safe
  void clear() noexcept {
    contacts_.clear();
    depths_.clear();
  }
  /// @return false where there is no more room   @rt safe
  bool add(const contact& c, const penetration& d) noexcept {
    if (contacts_.size() == most) return false;
    contacts_.push_back(c);
    depths_.push_back(d);
    return true;
  }
  [[nodiscard]] std::size_t size() const noexcept { return contacts_.size(); }
  [[nodiscard]] std::span<const contact> contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::span<const penetration> depths() const noexcept { return depths_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(contacts_, depths_); }

 private:
  std::vector<contact> contacts_;
  std::vector<penetration> depths_;
};

}  // namespace asperity
