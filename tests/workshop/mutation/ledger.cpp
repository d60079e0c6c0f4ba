#include "workshop/mutation/ledger.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace asperity::mutation {
namespace {

std::string fixed(double x, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

struct count {
  int caught = 0;
  int survived = 0;
  int not_built = 0;
  double seconds = 0;

  void add(const outcome& o) {
    caught += o.answer == verdict::caught;
    survived += o.answer == verdict::survived;
    not_built += o.answer == verdict::not_built;
    seconds += o.seconds;
  }
  [[nodiscard]] int all() const { return caught + survived + not_built; }
};

}  // namespace

ledger::ledger(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream in(file_);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string name;
    std::string answer;
    std::string seconds;
    entry e;
    if (!std::getline(fields, name, '\t') || !std::getline(fields, e.digest, '\t') ||
        !std::getline(fields, answer, '\t') || !std::getline(fields, e.what.test, '\t') ||
        !std::getline(fields, e.what.how, '\t') || !std::getline(fields, seconds, '\t')) {
      continue;  // a run was ended while it wrote this
    }
    for (const verdict v : {verdict::caught, verdict::survived, verdict::not_built}) {
      if (answer == to_string(v)) e.what.answer = v;
    }
    e.what.seconds = std::strtod(seconds.c_str(), nullptr);
    entries_[name] = e;
  }
}

const outcome* ledger::find(const std::string& name, const std::string& digest) const {
  const auto found = entries_.find(name);
  return found != entries_.end() && found->second.digest == digest ? &found->second.what : nullptr;
}

result<void> ledger::add(const std::string& name, const std::string& digest, const outcome& o) {
  entries_[name] = {digest, o};
  std::ofstream out(file_, std::ios::app);
  out << name << '\t' << digest << '\t' << to_string(o.answer) << '\t' << o.test << '\t' << o.how << '\t'
      << fixed(o.seconds, "%.1f") << '\n';
  out.close();
  if (!out) return error{error_code::io_failed, file_.string() + ": cannot be written"};
  return {};
}

std::string digest_of(const std::string& broken_source, const bug& what) {
  std::uint64_t h = 14695981039346656037U;  // FNV-1a
  const auto add = [&](const std::string& text) {
    for (const char c : text + '\n') h = (h ^ static_cast<unsigned char>(c)) * 1099511628211U;
  };
  add(broken_source);
  for (const std::string& test : what.tests) add(test);
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  return text;
}

std::string totals(const std::vector<finding>& findings) {
  count c;
  for (const finding& f : findings) c.add(f.became);
  return std::to_string(c.all()) + " bugs: " + std::to_string(c.caught) + " caught, " + std::to_string(c.survived) +
         " survived, " + std::to_string(c.not_built) + " not built";
}

std::string page(const std::vector<finding>& findings, const std::string& date) {
  std::ostringstream out;
  count whole;
  std::map<std::string, count> rooms;
  for (const finding& f : findings) {
    whole.add(f.became);
    rooms[f.what.room].add(f.became);
  }
  out << "# Bugs planted on purpose\n\n"
         "`./dev mutate` plants each of these bugs in a copy of the sources, builds the tests that stand for its place "
         "and runs\n"
         "them until one fails. `./dev test` runs the same tests. `./dev mutate` wrote this page; the list of bugs is "
         "in\n"
         "tests/workshop/mutation/catalogue.\n\n";
  out << date << ": " << totals(findings) << ", " << fixed(whole.seconds / 60.0, "%.0f")
      << " minutes of building and running.\n\n"
         "| Room | Bugs | Caught | Survived | Not built |\n|---|---:|---:|---:|---:|\n";
  for (const auto& [name, c] : rooms) {
    out << "| " << name << " | " << c.all() << " | " << c.caught << " | " << c.survived << " | " << c.not_built
        << " |\n";
  }
  std::string room;
  for (const finding& f : findings) {
    if (f.what.room != room) {
      room = f.what.room;
      out << "\n## " << room << "\n\n| Bug | Planted in | Change | Became | s |\n|---|---|---|---|---:|\n";
    }
    out << "| " << f.what.name << " | " << f.what.file;
    std::string in;
    std::string changes;
    for (const edit& e : f.what.edits) {
      if (e.in != in) out << (in.empty() ? ": `" : ", `") << e.in << '`';
      in = e.in;
      changes += (changes.empty() ? "`" : ", `") + e.operation + '`';
    }
    out << " | " << cell(changes) << " | " << to_string(f.became.answer);
    if (f.became.answer == verdict::caught) out << ": " << f.became.test << ", " << cell(f.became.how);
    out << " | " << fixed(f.became.seconds, "%.0f") << " |\n";
  }
  return out.str();
}

}  // namespace asperity::mutation
