// The rules of compilers ahead of time: native code calls only static methods that are marked with the type of their delegate, and the
// delegates live as long as the program. Prints their names.
using System;
using System.Linq;
using System.Reflection;
using System.Runtime.InteropServices;

static class Callbacks
{
    const BindingFlags All = BindingFlags.Static | BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

    static bool IsNative(Type type)
    {
        return type.IsDefined(typeof(UnmanagedFunctionPointerAttribute), false);
    }

    static bool IsMarked(MethodInfo method, Type type)
    {
        var marks = CustomAttributeData.GetCustomAttributes(method);
        return method.IsStatic && marks.Any(mark =>
            mark.Constructor.DeclaringType.FullName == "AOT.MonoPInvokeCallbackAttribute" && (Type)mark.ConstructorArguments[0].Value == type);
    }

    static int Main(string[] paths)
    {
        var types = Assembly.LoadFrom(paths[0]).GetTypes();
        // Those with < in their names are the compiler's.
        var fields = types.SelectMany(type => type.GetFields(All)).Where(field => IsNative(field.FieldType) && !field.Name.StartsWith("<")).ToArray();
        bool isWell = fields.All(field => field.IsStatic && field.IsInitOnly && IsMarked(((Delegate)field.GetValue(null)).Method, field.FieldType));
        foreach (var type in types.Where(IsNative))
            isWell &= fields.Count(field => field.FieldType == type) == 1;
        // The library takes no object of a type that is known only when the program runs.
        var natives = types.SelectMany(type => type.GetMethods(All)).Where(method => method.IsDefined(typeof(DllImportAttribute), false)).ToArray();
        isWell &= natives.Length > 50 && natives.All(method => method.GetParameters().All(one => !one.ParameterType.IsGenericType && one.ParameterType != typeof(object)));
        Console.WriteLine(string.Join(" ", fields.Select(field => ((Delegate)field.GetValue(null)).Method.Name).OrderBy(name => name)));
        return isWell ? 0 : 1;
    }
}
