/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneParameters_h
#define boneParameters_h

#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace bone
{
/** \defgroup Parameters The parameters of a stage
 * Each stage has one table of its parameters, a macro of one line each, and from it one struct:
 *
 * \code
 * #define BONE_DENSITY_FIT_PARAMETERS(value, flag)                                                                  \
 *   value(int, degree, Degree, 3, ParameterRange::Between(0, 8), "", "degree", "degree of the polynomials")         \
 *   flag(continuous, Continuous, false, "continuous", "one continuous density within each region")
 * BONE_PARAMETER_STRUCT(DensityFitParameters, BONE_DENSITY_FIT_PARAMETERS);
 * \endcode
 *
 * A line of `value` is: type, member of the struct, name of the filter's Set and Get, default, range (for numbers),
 * unit (empty: none), name of the option on the command line (empty: it has none) and one line of help; a line of
 * `flag` is the same for a bool, without range and unit. Types are numbers, enumerations with ParameterChoices, and
 * vectors of numbers. The table is the only place of a default. From it come
 * - the struct: `Visit()`, `Verify()`, == and !=;
 * - the filter's Set and Get, which mark it modified on change alone (BONE_FILTER_PARAMETERS), and its PrintSelf
 *   (PrintParameters);
 * - options and help of the command line, and the report's JSON, which visit the struct.
 * \{ */

/** The values that a number may have. NaN lies in no range, infinity in those that have no upper end only. */
struct ParameterRange
{
  double lower{ -std::numeric_limits<double>::infinity() };
  double upper{ std::numeric_limits<double>::infinity() };
  bool   open{ false };     ///< without the lower end itself
  bool   infinite{ false }; ///< infinity is a value
  double least{ 0.0 };      ///< a value that is not 0 is at least so large

  static constexpr ParameterRange
  Any()
  {
    return {};
  }
  static constexpr ParameterRange
  Positive()
  {
    return { 0.0, std::numeric_limits<double>::infinity(), true, false };
  }
  static constexpr ParameterRange
  NotNegative()
  {
    return { 0.0, std::numeric_limits<double>::infinity(), false, false };
  }
  /** A length in mm: from a micrometre, which no scanner of bones resolves, to ten metres, which no bone has. */
  static constexpr ParameterRange
  Length()
  {
    return { 0.001, 10000.0, false, false };
  }
  /** 0, or such a length. */
  static constexpr ParameterRange
  LengthOrZero()
  {
    return { 0.0, 10000.0, false, false, 0.001 };
  }
  /** 0 or more, or infinity. */
  static constexpr ParameterRange
  NotNegativeOrInfinite()
  {
    return { 0.0, std::numeric_limits<double>::infinity(), false, true };
  }
  static constexpr ParameterRange
  AtLeast(double lower)
  {
    return { lower, std::numeric_limits<double>::infinity(), false, false };
  }
  static constexpr ParameterRange
  Between(double lower, double upper)
  {
    return { lower, upper, false, false };
  }
  /** (lower, upper] */
  static constexpr ParameterRange
  Above(double lower, double upper)
  {
    return { lower, upper, true, false };
  }

  bool
  Contains(double x) const
  {
    return (open ? x > lower : x >= lower) && x <= upper && (infinite || std::isfinite(x)) &&
           (x == 0.0 || std::abs(x) >= least);
  }

  /** In words that follow "must be": "above 0", "0 to 8". */
  std::string
  Describe() const;
};

/** The names of an enumeration's values on the command line and in files, in the order of its values from 0 on;
 * specialised as `static constexpr std::array<const char *, n> names`. */
template <typename TEnumeration>
struct ParameterChoices;

/** What is known of a parameter beside its value. */
struct ParameterField
{
  const char *   member; ///< name in files: "degree"
  const char *   name;   ///< name of Set and Get: "Degree"
  ParameterRange range;  ///< of a number
  const char *   unit;   ///< "mm"; empty: none
  const char *   option; ///< on the command line: "degree"; empty: none
  const char *   help;   ///< one line
};

/** A value in words, as reports and PrintSelf have it. */
template <typename T>
std::string
ParameterText(const T & value)
{
  if constexpr (std::is_same_v<T, bool>)
  {
    return value ? "On" : "Off";
  }
  else if constexpr (std::is_enum_v<T>)
  {
    return ParameterChoices<T>::names[static_cast<std::size_t>(value)];
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    std::ostringstream text;
    text << value;
    return text.str();
  }
  else
  {
    std::string text;
    for (const auto & element : value)
    {
      text += (text.empty() ? "" : " ") + ParameterText(element);
    }
    return text;
  }
}

/** The value of an enumeration that has this name. Throws std::invalid_argument that lists the names where none has. */
template <typename TEnumeration>
TEnumeration
ParseChoice(const std::string & text)
{
  const auto & names = ParameterChoices<TEnumeration>::names;
  std::string  list;
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    if (text == names[i])
    {
      return static_cast<TEnumeration>(i);
    }
    list += (i == 0 ? "" : ", ") + std::string(names[i]);
  }
  throw std::invalid_argument('"' + text + "\" is none of " + list + '.');
}

/** Throws std::invalid_argument, naming the parameter and what it may be, where a value lies out of its range. */
template <typename T>
void
VerifyParameter(const ParameterField & field, const T & value)
{
  if constexpr (std::is_enum_v<T>)
  {
    if (static_cast<std::size_t>(value) >= ParameterChoices<T>::names.size())
    {
      throw std::invalid_argument(std::string(field.name) + " is no value of its enumeration.");
    }
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    if (!field.range.Contains(static_cast<double>(value)))
    {
      const std::string unit = *field.unit != '\0' ? ' ' + std::string(field.unit) : std::string();
      throw std::invalid_argument(std::string(field.name) + " is " + ParameterText(value) + unit + ", but must be " +
                                  field.range.Describe() + '.');
    }
  }
  else
  {
    for (const auto & element : value)
    {
      VerifyParameter(field, element);
    }
  }
}

/** For PrintSelf: a line for each. */
template <typename TIndent, typename TParameters>
void
PrintParameters(std::ostream & os, const TIndent & indent, const TParameters & parameters)
{
  TParameters::Visit(parameters, [&os, &indent](const ParameterField & field, const auto & value) {
    os << indent << field.name << ": " << ParameterText(value) << '\n';
  });
}
/** \} */
} // namespace bone

#define BONE_PARAMETER_MEMBER_VALUE(type, member, name, initial, range, unit, option, help) type member{ initial };
#define BONE_PARAMETER_MEMBER_FLAG(member, name, initial, option, help) bool member{ initial };
#define BONE_PARAMETER_VISIT_VALUE(type, member, name, initial, range, unit, option, help)                             \
  visit(::bone::ParameterField{ #member, #name, range, unit, option, help }, self.member);
#define BONE_PARAMETER_VISIT_FLAG(member, name, initial, option, help)                                                 \
  visit(::bone::ParameterField{ #member, #name, ::bone::ParameterRange::Any(), "", option, help }, self.member);
#define BONE_PARAMETER_EQUAL_VALUE(type, member, name, initial, range, unit, option, help) &&a.member == b.member
#define BONE_PARAMETER_EQUAL_FLAG(member, name, initial, option, help) &&a.member == b.member
#define BONE_PARAMETER_ACCESS_VALUE(type, member, name, initial, range, unit, option, help)                            \
  virtual void Set##name(type value)                                                                                   \
  {                                                                                                                    \
    if (!(m_Parameters.member == value))                                                                               \
    {                                                                                                                  \
      m_Parameters.member = std::move(value);                                                                          \
      this->Modified();                                                                                                \
    }                                                                                                                  \
  }                                                                                                                    \
  virtual const type & Get##name() const                                                                               \
  {                                                                                                                    \
    return m_Parameters.member;                                                                                        \
  }
#define BONE_PARAMETER_ACCESS_FLAG(member, name, initial, option, help)                                                \
  BONE_PARAMETER_ACCESS_VALUE(bool, member, name, initial, , , option, help)                                           \
  virtual void name##On()                                                                                              \
  {                                                                                                                    \
    this->Set##name(true);                                                                                             \
  }                                                                                                                    \
  virtual void name##Off()                                                                                             \
  {                                                                                                                    \
    this->Set##name(false);                                                                                            \
  }

/** Defines the struct of a table; see \ref Parameters. */
#define BONE_PARAMETER_STRUCT(Struct, TABLE)                                                                           \
  struct Struct                                                                                                        \
  {                                                                                                                    \
    TABLE(BONE_PARAMETER_MEMBER_VALUE, BONE_PARAMETER_MEMBER_FLAG)                                                     \
    /** Calls visit(ParameterField, value) for each parameter, in the table's order. */                                \
    template <typename TSelf, typename TVisitor>                                                                       \
    static void                                                                                                        \
    Visit(TSelf & self, TVisitor && visit)                                                                             \
    {                                                                                                                  \
      TABLE(BONE_PARAMETER_VISIT_VALUE, BONE_PARAMETER_VISIT_FLAG)                                                     \
    }                                                                                                                  \
    /** Throws std::invalid_argument that names a parameter out of its range. */                                       \
    void                                                                                                               \
    Verify() const                                                                                                     \
    {                                                                                                                  \
      Visit(*this,                                                                                                     \
            [](const ::bone::ParameterField & field, const auto & value) { ::bone::VerifyParameter(field, value); });  \
    }                                                                                                                  \
    friend bool                                                                                                        \
    operator==(const Struct & a, const Struct & b)                                                                     \
    {                                                                                                                  \
      return true TABLE(BONE_PARAMETER_EQUAL_VALUE, BONE_PARAMETER_EQUAL_FLAG);                                        \
    }                                                                                                                  \
    friend bool                                                                                                        \
    operator!=(const Struct & a, const Struct & b)                                                                     \
    {                                                                                                                  \
      return !(a == b);                                                                                                \
    }                                                                                                                  \
  }

/** Gives a process object its parameters: the member m_Parameters, SetParameters, GetParameters, Set and Get of each,
 * and VerifyParameters, for VerifyPreconditions, which throws itk::ExceptionObject. To stand in its public part. */
#define BONE_FILTER_PARAMETERS(Struct, TABLE)                                                                          \
  TABLE(BONE_PARAMETER_ACCESS_VALUE, BONE_PARAMETER_ACCESS_FLAG)                                                       \
  void SetParameters(const Struct & parameters)                                                                        \
  {                                                                                                                    \
    if (!(m_Parameters == parameters))                                                                                 \
    {                                                                                                                  \
      m_Parameters = parameters;                                                                                       \
      this->Modified();                                                                                                \
    }                                                                                                                  \
  }                                                                                                                    \
  const Struct & GetParameters() const                                                                                 \
  {                                                                                                                    \
    return m_Parameters;                                                                                               \
  }                                                                                                                    \
                                                                                                                       \
protected:                                                                                                             \
  void VerifyParameters() const                                                                                        \
  {                                                                                                                    \
    try                                                                                                                \
    {                                                                                                                  \
      m_Parameters.Verify();                                                                                           \
    }                                                                                                                  \
    catch (const std::invalid_argument & error)                                                                        \
    {                                                                                                                  \
      itkExceptionMacro("" << error.what());                                                                           \
    }                                                                                                                  \
  }                                                                                                                    \
  Struct m_Parameters;                                                                                                 \
                                                                                                                       \
public:

/** BONE_FILTER_PARAMETERS of a filter that checks and prints nothing else: VerifyPreconditions and PrintSelf too. */
#define BONE_PLAIN_FILTER_PARAMETERS(Struct, TABLE)                                                                    \
  BONE_FILTER_PARAMETERS(Struct, TABLE)                                                                                \
protected:                                                                                                             \
  void VerifyPreconditions() const override                                                                            \
  {                                                                                                                    \
    Superclass::VerifyPreconditions();                                                                                 \
    this->VerifyParameters();                                                                                          \
  }                                                                                                                    \
  void PrintSelf(std::ostream & os, itk::Indent indent) const override                                                 \
  {                                                                                                                    \
    Superclass::PrintSelf(os, indent);                                                                                 \
    ::bone::PrintParameters(os, indent, m_Parameters);                                                                 \
  }                                                                                                                    \
                                                                                                                       \
public:

#endif
