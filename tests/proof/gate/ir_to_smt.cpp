#include "proof/gate/ir_to_smt.hpp"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

namespace asperity::proof {
namespace {

const char* const float64 = "(_ FloatingPoint 11 53)";

std::string binary(std::uint64_t bits, int digits) {
  std::string out = "#b";
  for (int i = digits - 1; i >= 0; --i) out += (bits >> i & 1U) != 0 ? '1' : '0';
  return out;
}

struct definition {
  std::string sort;
  std::string term;
  std::vector<std::string> uses;  // names of other values
  std::string passed;             // of a select: the value it lets through
};

const std::map<std::string, std::string>& arithmetic() {
  static const std::map<std::string, std::string> table{
      {"fadd", "fp.add RNE"}, {"fsub", "fp.sub RNE"}, {"fmul", "fp.mul RNE"}, {"fdiv", "fp.div RNE"}};
  return table;
}

// Ordered comparisons are false where a NaN is involved, unordered ones true: the negation of the opposite ordered one.
std::optional<std::string> comparison(const std::string& kind, const std::string& a, const std::string& b) {
  const auto is = [&](const char* op) { return "(" + std::string(op) + ' ' + a + ' ' + b + ')'; };
  const auto isnt = [&](const char* op) { return "(not " + is(op) + ')'; };
  if (kind == "ole") return is("fp.leq");
  if (kind == "olt") return is("fp.lt");
  if (kind == "oge") return is("fp.geq");
  if (kind == "ogt") return is("fp.gt");
  if (kind == "oeq") return is("fp.eq");
  if (kind == "ule") return isnt("fp.gt");
  if (kind == "ult") return isnt("fp.geq");
  if (kind == "uge") return isnt("fp.lt");
  if (kind == "ugt") return isnt("fp.leq");
  if (kind == "une") return isnt("fp.eq");
  return std::nullopt;
}

class translator {
 public:
  translator(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs)
      : inputs_(&inputs), outputs_(&outputs) {}

  result<void> read(const std::string& ir) {
    static const std::regex head(R"(^define [^\n]*@\w+\(([^\n]*)\) [^\n]*\{$)");
    std::istringstream lines(ir);
    std::string line;
    bool inside = false;
    while (std::getline(lines, line)) {
      std::smatch m;
      if (std::regex_search(line, m, head)) {
        if (functions_++ > 0) return refuse("a second function", line);
        if (result<void> named = name_arguments(m[1]); !named) return named;
        inside = true;
      } else if (line == "}") {
        inside = false;
      } else if (inside && !line.empty()) {
        if (result<void> read = instruction(line.substr(line.find_first_not_of(' '))); !read) return read;
        ++lines_;
      }
    }
    if (functions_ == 0) return error{error_code::invalid_argument, "the IR holds no function definition"};
    if (stored_.size() != outputs_->size()) {
      return error{error_code::invalid_argument, "the IR stores " + std::to_string(stored_.size()) + " results where " +
                                                     std::to_string(outputs_->size()) + " are expected"};
    }
    return {};
  }

  translation write(cut what) const {
    translation out;
    out.lines = lines_;
    const std::set<std::string> free = values_to_cut(what);
    out.cuts = free.size();
    std::set<std::string> needed;
    std::vector<std::string> open;
    for (const auto& [index, value] : stored_) open.push_back(value);
    while (!open.empty()) {
      const std::string value = open.back();
      open.pop_back();
      if (values_.count(value) == 0 || !needed.insert(value).second || free.count(value) > 0) continue;
      for (const std::string& use : values_.at(value).uses) open.push_back(use);
    }
    for (const auto& [name, sort] : arguments_) out.smt += "(declare-const " + name + ' ' + sort + ")\n";
    for (const std::string& name : order_) {
      if (needed.count(name) == 0) continue;
      const definition& d = values_.at(name);
      out.smt += free.count(name) > 0 ? "(declare-const " + name + ' ' + d.sort + ")\n"
                                      : "(define-fun " + name + " () " + d.sort + ' ' + d.term + ")\n";
    }
    for (const auto& [index, value] : stored_) {
      out.smt += "(define-fun " + (*outputs_)[index] + " () " + float64 + ' ' + value + ")\n";
    }
    return out;
  }

 private:
  std::set<std::string> values_to_cut(cut what) const {
    std::set<std::string> out;
    if (what == cut::before_outputs) {
      for (const auto& [index, value] : stored_) {
        const auto found = values_.find(value);
        if (found != values_.end() && found->second.sort == float64 && values_.count(found->second.passed) > 0) {
          out.insert(found->second.passed);
        }
      }
    }
    if (what == cut::quotients_and_roots) {
      for (const auto& [name, value] : values_) {
        if (value.term.rfind("(fp.div ", 0) == 0 || value.term.rfind("(fp.sqrt ", 0) == 0) out.insert(name);
      }
    }
    return out;
  }

  static error refuse(const char* what, const std::string& line) {
    return {error_code::unsupported, std::string("the IR holds ") + what + ", which is not translated: " + line};
  }

  // A value as the solver knows it: an argument by its name, another value as |%n|, a constant bit for bit.
  std::string operand(const std::string& text) const {
    if (text == "true" || text == "false") return text;
    if (text[0] == '%') {
      const auto found = renamed_.find(text);
      return found != renamed_.end() ? found->second : '|' + text + '|';
    }
    if (text.rfind("0x", 0) == 0) {
      return smt_literal(std::bit_cast<double>(static_cast<std::uint64_t>(std::strtoull(text.c_str(), nullptr, 16))));
    }
    return smt_literal(std::strtod(text.c_str(), nullptr));
  }

  result<void> name_arguments(const std::string& list) {
    std::istringstream split(list);
    std::string argument;
    for (std::size_t i = 0; std::getline(split, argument, ','); ++i) {
      const std::string name = argument.substr(argument.find('%'));
      std::istringstream words(argument);
      std::string type;
      words >> type;
      if (type == "double*") {
        places_[name] = 0;
        continue;
      }
      if ((type != "double" && type != "i1") || i >= inputs_->size()) return refuse("an argument", argument);
      renamed_[name] = (*inputs_)[i];
      arguments_.emplace_back((*inputs_)[i], type == "double" ? float64 : "Bool");
    }
    return {};
  }

  result<void> instruction(const std::string& line) {
    static const std::regex place(R"(^(%\d+) = getelementptr inbounds double, double\* (%\d+), i64 (\d+)$)");
    static const std::regex store(R"(^store double (\S+), double\* (%\d+),.*$)");
    static const std::regex assignment(R"(^(%\d+) = (.*?)( #\d+)?$)");
    std::smatch m;
    if (line == "ret void") return {};
    if (std::regex_match(line, m, place) && places_.count(m[2]) > 0) {
      places_[m[1]] = places_[m[2]] + std::stoul(m[3]);
      return {};
    }
    if (std::regex_match(line, m, store) && places_.count(m[2]) > 0 && places_[m[2]] < outputs_->size()) {
      stored_[places_[m[2]]] = operand(m[1]);
      return {};
    }
    if (!std::regex_match(line, m, assignment)) return refuse("an instruction", line);
    const std::string name = '|' + m[1].str() + '|';
    std::optional<definition> d = define(m[2]);
    if (!d) return refuse("an instruction", line);
    order_.push_back(name);
    values_[name] = std::move(*d);
    return {};
  }

  std::optional<definition> define(const std::string& text) const {
    // No flag is let through: `fast`, `nnan` and their kind would permit other results than IEEE 754's.
    static const std::regex binary_op(R"(^(fadd|fsub|fmul|fdiv) double (\S+), (\S+)$)");
    static const std::regex compare(R"(^fcmp (\w+) double (\S+), (\S+)$)");
    static const std::regex logic(R"(^(and|or|xor) i1 (\S+), (\S+)$)");
    static const std::regex choose(R"(^select i1 (\S+), (double|i1) (\S+), (?:double|i1) (\S+)$)");
    static const std::regex call(R"(^(?:tail )?call double @llvm\.(fabs|sqrt)\.f64\(double (?:noundef )?(\S+)\)$)");
    static const std::regex negate(R"(^fneg double (\S+)$)");
    std::smatch m;
    const auto made = [](const char* sort, std::string term, std::vector<std::string> uses) {
      return definition{sort, std::move(term), std::move(uses), {}};
    };
    if (std::regex_match(text, m, binary_op)) {
      const std::string a = operand(m[2]), b = operand(m[3]);
      return made(float64, '(' + arithmetic().at(m[1]) + ' ' + a + ' ' + b + ')', {a, b});
    }
    if (std::regex_match(text, m, compare)) {
      const std::string a = operand(m[2]), b = operand(m[3]);
      const std::optional<std::string> term = comparison(m[1], a, b);
      if (!term) return std::nullopt;
      return made("Bool", *term, {a, b});
    }
    if (std::regex_match(text, m, logic)) {
      const std::string a = operand(m[2]), b = operand(m[3]);
      return made("Bool", '(' + m[1].str() + ' ' + a + ' ' + b + ')', {a, b});
    }
    if (std::regex_match(text, m, choose)) {
      const std::string c = operand(m[1]), a = operand(m[3]), b = operand(m[4]);
      definition d = made(m[2] == "double" ? float64 : "Bool", "(ite " + c + ' ' + a + ' ' + b + ')', {c, a, b});
      d.passed = a;
      return d;
    }
    if (std::regex_match(text, m, call)) {
      const std::string a = operand(m[2]);
      return made(float64, (m[1] == "fabs" ? "(fp.abs " : "(fp.sqrt RNE ") + a + ')', {a});
    }
    if (std::regex_match(text, m, negate)) return made(float64, "(fp.neg " + operand(m[1]) + ')', {operand(m[1])});
    return std::nullopt;
  }

  const std::vector<std::string>* inputs_;
  const std::vector<std::string>* outputs_;
  std::size_t functions_ = 0;
  std::size_t lines_ = 0;
  std::vector<std::pair<std::string, std::string>> arguments_;
  std::map<std::string, std::string> renamed_;  // of the IR's arguments
  std::map<std::string, std::size_t> places_;   // addresses of results
  std::map<std::size_t, std::string> stored_;   // results
  std::map<std::string, definition> values_;
  std::vector<std::string> order_;
};

}  // namespace

std::string smt_literal(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return "(fp " + binary(bits >> 63, 1) + ' ' + binary(bits >> 52 & 0x7ffU, 11) + ' ' +
         binary(bits & 0xfffffffffffffU, 52) + ')';
}

result<translation> to_smt(const std::string& ir, const std::vector<std::string>& inputs,
                           const std::vector<std::string>& outputs, cut what) {
  translator t(inputs, outputs);
  if (result<void> read = t.read(ir); !read) return read.error();
  return t.write(what);
}

}  // namespace asperity::proof
