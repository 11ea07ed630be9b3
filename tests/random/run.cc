#include "run.h"

#include <slipstick/app/simulation.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/utilities.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>

#include <zlib.h>

namespace slipstick::random
{
  namespace
  {
    std::string content(const std::string &path)
    {
      std::ifstream     in(path);
      std::stringstream text;
      text << in.rdbuf();
      return text.str();
    }

    /// Bytes of a text in base64; deal.II's function does not know padding.
    std::vector<unsigned char> decoded(std::string text)
    {
      const unsigned int n_padding = std::count(text.begin(), text.end(), '=');
      std::replace(text.begin(), text.end(), '=', 'A');
      auto bytes = dealii::Utilities::decode_base64(text);
      bytes.resize(bytes.size() - n_padding);
      return bytes;
    }

    /// The numbers of a DataArray (Float32, one compressed block); @p tag: what its tag contains.
    std::vector<float> array(const std::string &vtu, const std::string &tag)
    {
      const auto at    = vtu.find(tag);
      const auto begin = vtu.find(">\n", at + tag.size()) + 2, end = vtu.find("\n</DataArray>", begin);
      AssertThrow(at != std::string::npos && end != std::string::npos, dealii::ExcMessage("no " + tag + " in .vtu"));
      constexpr unsigned int header  = 24; // 16 bytes in base64
      const auto             bytes   = decoded(vtu.substr(begin + header, end - begin - header));
      const auto             numbers = decoded(vtu.substr(begin, header));
      std::uint32_t          size;
      std::memcpy(&size, numbers.data() + 4, 4);
      std::vector<float> values(size / sizeof(float));
      uLongf             length = size;
      AssertThrow(uncompress(reinterpret_cast<Bytef *>(values.data()), &length, bytes.data(), bytes.size()) == Z_OK &&
                    length == size,
                  dealii::ExcMessage("zlib"));
      return values;
    }

    void read_displacements(const Problem &problem, const std::string &directory, RunResult &result)
    {
      constexpr double not_seen = std::numeric_limits<double>::quiet_NaN();
      result.u                  = Eigen::VectorXd::Constant(problem.f.size(), not_seen);
      double largest            = 0;
      for (unsigned int s = 0;; ++s)
        {
          char name[64];
          std::snprintf(name, sizeof(name), "/subdomain_000_%04u.vtu", s);
          const std::string vtu = content(directory + name);
          if (vtu.empty())
            break;
          const auto points = array(vtu, "<Points>"), u = array(vtu, "\"displacement\""),
                     bodies = array(vtu, "\"body\"");
          const auto &body  = problem.bodies[std::lround(bodies.at(0))];
          for (unsigned int i = 0; 3 * i < points.size(); ++i)
            {
              const Eigen::Vector2d x(points[3 * i], points[3 * i + 1]);
              int                   nearest  = -1;
              double                distance = 1e-5 * problem.size;
              for (int node = body.first / 2; node < (body.first + body.K.rows()) / 2; ++node)
                if ((problem.positions[node] - x).norm() < distance)
                  {
                    distance = (problem.positions[node] - x).norm();
                    nearest  = node;
                  }
              AssertThrow(nearest >= 0, dealii::ExcMessage("a node of the .vtu is not in the untorn mesh"));
              for (const int c : {0, 1})
                {
                  const double value = u[3 * i + c];
                  double      &there = result.u[2 * nearest + c];
                  if (!std::isnan(there))
                    result.copies_differ = std::max(result.copies_differ, std::abs(there - value));
                  there   = value;
                  largest = std::max(largest, std::abs(value));
                }
            }
        }
      AssertThrow(!result.u.hasNaN(), dealii::ExcMessage("a node of the untorn mesh is in no .vtu"));
      result.copies_differ /= std::max(largest, 1e-13 * problem.size);
    }

    std::vector<std::string> split(const std::string &line)
    {
      std::vector<std::string> words;
      std::stringstream        in(line);
      for (std::string word; std::getline(in, word, ',');)
        words.push_back(word);
      return words;
    }

    /// Nodes of a pair at the same place (corners) come in the same order in every run.
    void read_forces(const scene::Scene<2> &scene,
                     const Problem         &problem,
                     const std::string     &directory,
                     RunResult             &result)
    {
      result.x = Eigen::VectorXd::Zero(problem.rows.size());
      std::vector<char> is_taken(problem.nodes.size(), 0);
      std::ifstream     in(directory + "/contact.csv");
      std::string       line;
      std::getline(in, line);
      while (std::getline(in, line))
        {
          const auto   words = split(line);
          const double x = std::stod(words[2]), y = std::stod(words[3]);
          double       closest = 1e-9 * problem.size;
          int          found   = -1;
          for (unsigned int i = 0; i < problem.nodes.size(); ++i)
            {
              const auto &node = problem.nodes[i];
              if (is_taken[i] || scene.contacts[node.pair].name != words[0])
                continue;
              const double distance = std::hypot(node.position[0] - x, node.position[1] - y);
              if (distance < closest)
                {
                  closest = distance;
                  found   = i;
                }
            }
          AssertThrow(found >= 0,
                      dealii::ExcMessage("a contact node of pair " + words[0] + " is not in the untorn problem"));
          is_taken[found]  = 1;
          const auto &node = problem.nodes[found];
          if (node.normal >= 0)
            result.x[node.normal] = std::stod(words[6]) * node.area;
          if (node.tangential >= 0)
            result.x[node.tangential] = -std::stod(words[7]) * node.area;
        }
    }

    /// Standard error is kept for this scope.
    class Silence
    {
    public:
      Silence()
        : buffer(std::cerr.rdbuf(text.rdbuf()))
      {}
      ~Silence()
      {
        std::cerr.rdbuf(buffer);
      }

    private:
      std::stringstream text;
      std::streambuf   *buffer;
    };
  } // namespace

  RunResult run(const scene::Scene<2> &scene, const Problem &problem, const std::string &directory, const MPI_Comm comm)
  {
    RunResult result;
    try
      {
        const Silence silence;
        const Log     log(comm, Verbosity::quiet);
        result.status = app::run(scene, {}, directory, false, log, comm);
      }
    catch (const InputError &error)
      {
        result.status  = ExitStatus::bad_input;
        result.message = error.what();
      }
    catch (const NoEquilibrium &error)
      {
        result.status  = ExitStatus::no_equilibrium;
        result.message = error.what();
      }
    catch (const std::exception &error)
      {
        result.status  = ExitStatus::internal_error;
        result.message = error.what();
      }
    if (result.status == ExitStatus::converged || result.status == ExitStatus::not_converged)
      {
        read_displacements(problem, directory, result);
        read_forces(scene, problem, directory, result);
        const auto summary     = nlohmann::json::parse(content(directory + "/summary.json"));
        result.multiplications = summary["solver"]["hessian_multiplications"].get<unsigned long long>();
        result.fallbacks       = summary["solver"]["fallbacks"].get<unsigned int>();
        for (const auto &support : summary["results"]["supports"])
          if (support["support"] == "held motions")
            result.still_load = std::hypot(support["force"][0].get<double>(), support["force"][1].get<double>()) +
                                std::abs(support["moment"].get<double>()) / problem.size;
        for (const auto &warning : summary["warnings"])
          result.holds_motions |= warning.get<std::string>().rfind("nothing resists", 0) == 0;
        double worst = 0;
        for (const auto &[name, value] : summary["residuals"].items())
          if (value.is_number() && value.get<double>() >= worst)
            {
              worst              = value.get<double>();
              result.worst_check = name + " " + std::to_string(worst);
            }
      }
    return result;
  }
} // namespace slipstick::random
